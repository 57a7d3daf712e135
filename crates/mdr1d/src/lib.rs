//! The method of reduction of dimensionality: rough lines and axisymmetric bodies on a Winkler foundation.
