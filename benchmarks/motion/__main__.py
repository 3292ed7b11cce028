"""python -m benchmarks.motion make | run | score."""

from benchmarks.motion.commands import main

raise SystemExit(main())
