//! Nothing: the manifest of this package names features.
