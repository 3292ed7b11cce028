"""Which instrument shows which effect, by the diagnosis' own figures."""
