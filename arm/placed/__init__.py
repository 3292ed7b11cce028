"""Links as bodies in space: their frames, the views of drawings, and the orientation of their sections."""
