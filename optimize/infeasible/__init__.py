"""Why a problem has no answer: what no design can reach, and what each limit would have to be."""
