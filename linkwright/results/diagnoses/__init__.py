"""What a diagnosis says: in a sentence, in words and figures, with its evidence; and two of them compared."""
