"""The forearm may be of softer stuff, by 60 %: the robust design gives that link more of the mass than the nominal."""

import plotly.graph_objects as go

import linkwright as lw

arm = lw.read_arm("examples/bench-arm/arm.yaml")
asked = {"subject_to": {"mass": "<= 1.5 kg", "section_size": ["15 mm", "80 mm"]}, "choose": {"section": ["circle"]}}
doubt = lw.Problem(arm, **asked, uncertain={"elastic_modulus": ["5 %", "60 %"]}, robust="worst")
best = {"nominal": lw.optimize(lw.Problem(arm, **asked)).arm, "robust": lw.optimize(doubt).arm}
figure = go.Figure(layout={"barmode": "group", "yaxis_title": "worst error in mm"})
for name, each in best.items():
    found = lw.evaluate(each, doubt)
    errors = [found.max_error_mm, 1e3 * found.robust.value]
    print(f"{name}: {errors[0]:.4f} mm as drawn, {errors[1]:.4f} mm at worst")
    figure.add_bar(x=["as drawn", "the worst that may be"], y=errors, name=name)
