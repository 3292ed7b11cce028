"""What a diagnosis of motion logs says: in a sentence, in words and figures, with its evidence."""
