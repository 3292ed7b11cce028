"""What arm files say of flanges, and of links whose stiffness is given as such."""
