"""What is drawn and recorded: arms, concealed physics and measurements, sharing no code with what is judged."""
