"""Several recordings at once: physics shared; frame, tool, target and instrument each recording's own."""
