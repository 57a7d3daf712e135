//! Closed forms of normal contact, each one a model behind the common trait.
