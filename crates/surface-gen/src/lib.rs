//! Self-affine rough surfaces and lines, deterministic indenters, and what is measured on them.
