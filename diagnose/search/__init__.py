"""Which patterns explain a recording: exhaustive search, its calibration, names and their aliases."""
