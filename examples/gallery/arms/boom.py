"""A boom that runs out of its sleeve bends over what is out of it: four times the reach, seventy times the sag."""

import plotly.graph_objects as go

import linkwright as lw

bar = lw.Link(length="1.5 m", bends_over="q1", section="SHS 60x4", material="steel-s235")


def sag(out):
    """The worst error in mm of the boom that runs out so far (m)."""
    slide = lw.Joint(type="prismatic", range=["0.2 m", f"{out} m"])
    return lw.evaluate(lw.Arm([(slide, bar)], payload={"mass": "10 kg"})).max_error_mm


out = [0.3, 0.6, 0.9, 1.2, 1.5]
errors = [sag(each) for each in out]
print(f"{errors[0]:.3f} mm at {out[0]} m, {errors[3]:.3f} mm at {out[3]} m")
figure = go.Figure(go.Scatter(x=out, y=errors, mode="lines+markers"))
figure.update_layout(xaxis_title="run out in m", yaxis_title="worst error in mm")
