"""Files of other programs: bags, foreign column names, and the settings that make recordings of them."""
