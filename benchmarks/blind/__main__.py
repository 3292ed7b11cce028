"""python -m benchmarks.blind make | run | score | remake | publish."""

from benchmarks.blind.commands import main

raise SystemExit(main())
