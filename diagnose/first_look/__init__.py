"""The first look at a recording: whether it is meant as it is read, before physics is asked."""
