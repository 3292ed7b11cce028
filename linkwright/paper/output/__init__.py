"""The paper's tables and figures as pages, pictures, files and on the screen."""
