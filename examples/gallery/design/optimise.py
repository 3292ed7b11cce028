"""Better links within a kilogram: the shapes and sizes of the least worst error, and what is left of each effect."""

import plotly.graph_objects as go

import linkwright as lw

best = lw.optimize("examples/bench-arm/problem.yaml")
print(f"{best.before.max_error_mm:.3f} mm before, {best.max_error_mm:.3f} mm after; {best.mass_kg:.2f} kg of links")
print(best.links[["link", "section"]].to_string(index=False))
figure = go.Figure(layout={"barmode": "group", "xaxis_title": "error at the worst pose in mm"})
for name, arm in (("after", best.arm), ("before", "examples/bench-arm/arm.yaml")):
    table = lw.evaluate(arm).by_effect[::-1]
    figure.add_bar(y=table["effect"], x=table["error_mm"], name=name, orientation="h")
