"""Only some points count: places where the arm puts parts down, and the error at each, beside the worst anywhere."""

import plotly.graph_objects as go

import linkwright as lw

arm = lw.read_arm("examples/bench-arm/arm.yaml")
points = [(600, 100), (450, 350), (250, 500), (300, -150)]
figure = go.Figure(layout={"xaxis_title": "x in mm", "yaxis_title": "y in mm", "showlegend": False})
worst = 0.0
for x, y in points:
    there = lw.Problem(arm, workspace={"points": [[f"{x} mm", f"{y} mm"]]})
    error = lw.evaluate(arm, there).max_error_mm
    worst = max(worst, error)
    figure.add_scatter(x=[x], y=[y], mode="markers+text", text=f"{error:.2f} mm", textposition="middle right")
    figure.data[-1].marker.size = 30.0 * error
print(f"at most {worst:.3f} mm at the points, {lw.evaluate(arm).max_error_mm:.3f} mm anywhere")
figure.update_layout(xaxis_range=[200, 750], yaxis_range=[-250, 600])
