"""How far off is the tip of an arm at its worst, and which physics is to blame?"""

import linkwright as lw

found = lw.evaluate("examples/bench-arm/arm.yaml")
print(f"no pose is worse than {found.upper_bound_mm:.2f} mm")
figure = found.plot()
