"""What does a kilogram buy? Designs of which none is better in both mass and error."""

import linkwright as lw

problem = lw.read_problem("examples/bench-arm/problem.yaml").replace("choose", {"section": ["tube"]})
front = lw.tradeoff(problem, x="mass", y="max_error", accuracy=0.1)
print(f"{len(front.table)} designs, from {front.table['mass_kg'].min():.2f} to {front.table['mass_kg'].max():.2f} kg")
figure = front.plot()
