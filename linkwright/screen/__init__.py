"""What a terminal shows: tables, bars and progress, readable without colours and at a width of 100."""
