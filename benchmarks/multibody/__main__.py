"""python -m benchmarks.multibody make | run | score."""

from benchmarks.multibody.commands import main

raise SystemExit(main())
