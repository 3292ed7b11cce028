"""What the pages draw of results beside the arm itself: maps, charts, bars."""
