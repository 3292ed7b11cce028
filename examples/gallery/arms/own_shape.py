"""A shape of one's own, a square tube of one width and one wall: read in arm files, drawn and sized like any other."""

from dataclasses import dataclass
from typing import ClassVar

import plotly.graph_objects as go

import linkwright as lw


@dataclass(frozen=True)
class SquareTube(lw.Shape):
    """A square tube; dimensions in m."""

    side: float
    wall: float

    shape: ClassVar[str] = "square_tube"
    dimensions: ClassVar[tuple[lw.Dimension, ...]] = (
        lw.Dimension("side", "outer width and height", "outer"),
        lw.Dimension("wall", "thickness of all walls", "wall"),
    )

    def properties(self, poisson_ratio):
        """Area, second moments and the rest, SI."""
        return lw.shapes["rectangular_tube"](self.side, self.side, self.wall).properties(poisson_ratio)

    def outline(self):
        """What is drawn."""
        return lw.shapes["rectangular_tube"](self.side, self.side, self.wall).outline()


lw.shapes.register(SquareTube)
asked = {"mass": "<= 0.8 kg", "section_size": ["20 mm", "80 mm"], "thickness": ["1 mm", "6 mm"]}
arm = lw.read_arm("examples/bench-arm/arm.yaml")
figure = go.Figure(layout={"xaxis_title": "worst error in mm"})
for name in ("tube", "square_tube"):
    best = lw.optimize(lw.Problem(arm, subject_to=asked, choose={"section": [name]}))
    print(f"{name}: {best.max_error_mm:.4f} mm with {best.mass_kg:.3f} kg")
    figure.add_bar(y=[name], x=[best.max_error_mm], orientation="h", showlegend=False)
