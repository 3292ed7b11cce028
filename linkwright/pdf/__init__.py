"""Reports on paper: the same described results and pictures as the pages, set by Typst."""
