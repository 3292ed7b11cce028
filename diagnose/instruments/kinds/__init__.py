"""The kinds of instruments, one file each."""
