"""The paper's expansions: small nutation, matched solution, hypergeometric form."""
