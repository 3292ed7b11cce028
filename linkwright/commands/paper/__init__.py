"""`linkwright tables` and `linkwright figures`: the paper's, beside the truth."""
