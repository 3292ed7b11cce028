"""The paper beside the truth: its tables and figures as printed, reproduced, as its equations read, and corrected."""
