"""python -m benchmarks.blind make | run | score."""

from benchmarks.blind.commands import main

raise SystemExit(main())
