//! Exact normal contact of an elastic half-space with a rough square by boundary elements.
