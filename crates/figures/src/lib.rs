//! The figures of Pohrt, Popov and Filippov (2012) as code: runs, tables, pictures, comparison.
