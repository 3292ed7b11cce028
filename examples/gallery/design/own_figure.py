"""A figure of one's own, the girth of a section: evaluated, swept and limited like the shipped ones."""

import plotly.graph_objects as go

import linkwright as lw


def girth(section, _material):
    """Of the box around a section, m; None where it is not known."""
    outer = section.given()
    return (2.0 * (outer["width"] + outer["height"]),) if "width" in outer and "height" in outer else None


follows = lw.OfLinks(girth)
lw.limits.register(lw.Figure("girth", "greatest girth", ("<=",), "girth_mm", follows, "length", "mm", 1e3))
arm = lw.read_arm("examples/bench-arm/arm.yaml")
asked = {"mass": "<= 1 kg", "section_size": ["20 mm", "80 mm"], "thickness": ["2 mm", "6 mm"]}
girths, errors = [160, 200, 240], []
for most in girths:
    problem = lw.Problem(arm, subject_to={**asked, "girth": f"<= {most} mm"}, choose={"section": ["rectangular_tube"]})
    errors.append(lw.optimize(problem).max_error_mm)
print(f"{errors[0]:.3f} mm within {girths[0]} mm around, {errors[-1]:.3f} mm within {girths[-1]} mm")
figure = go.Figure(go.Scatter(x=girths, y=errors, mode="lines+markers"))
figure.update_layout(xaxis_title="girth allowed in mm", yaxis_title="worst error in mm")
