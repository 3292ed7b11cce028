"""The linear model of joint torques: candidates' columns, their products, and what is inferred from those alone."""
