"""A second proof of the diagnosis, on a multibody engine (MuJoCo): arms that leave first order, many causes at once,
physics that no part of the tool was written for.

Nothing here comes from the packages that are judged, nor does the engine share a formula with the first generator of
`benchmarks.blind`; of that come the sections' figures, the arm file's spelling, the seals, the runner and the counting.
"""
