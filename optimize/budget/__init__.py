"""What an arm is to be expected to err by, cause by cause, from data sheets and tolerances."""
