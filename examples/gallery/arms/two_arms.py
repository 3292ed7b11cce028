"""Two arms on one torso: what the worse tip errs by, over the load that the right one carries."""

import plotly.graph_objects as go

import linkwright as lw

turn = {"range": ["-90 deg", "90 deg"], "stiffness": "30 kN*m/rad"}
torso = (lw.Joint(**turn), lw.Link(length="400 mm", direction=[0, 0, 1], section="SHS 80x4", material="steel-s235"))
hand = {"joint": {"axis": "y", **turn}, "link": {"length": "500 mm", "section": "SHS 40x3", "material": "steel-s235"}}


def worst(load):
    """The worst error of either tip in mm."""
    sides = (("left", "0.2 m", "1 kg"), ("right", "-0.2 m", load))
    branches = [
        {"name": name, "origin": {"xyz": ["0 m", y, "0 m"]}, "payload": {"mass": mass}, "chain": [hand]}
        for name, y, mass in sides
    ]
    arm = lw.Arm([torso], gravity=["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"], branches=branches)
    return lw.evaluate(arm).max_error_mm


loads = ["0 kg", "4 kg", "8 kg"]
errors = [worst(load) for load in loads]
print(f"{errors[0]:.3f} mm, and {errors[-1]:.3f} mm with {loads[-1]} on the right")
figure = go.Figure(go.Scatter(x=loads, y=errors, mode="lines+markers"))
figure.update_layout(xaxis_title="payload of the right arm", yaxis_title="worst error of both tips in mm")
