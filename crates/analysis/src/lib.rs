//! Ensembles, power-law fits, collapse and conductance: from contact states to the numbers of the paper.
