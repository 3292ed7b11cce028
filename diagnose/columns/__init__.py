"""What the columns of another program's file may mean, and the settings that say so."""
