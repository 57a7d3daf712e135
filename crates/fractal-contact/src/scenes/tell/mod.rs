//! What is told of the states: tables, pictures, the report, the manifest. All are views of the states.

pub(crate) mod columns;
pub(crate) mod distributions;
pub(crate) mod ensemble;
pub(crate) mod info;
pub(crate) mod manifest;
pub(crate) mod page;
pub(crate) mod pictures;
pub(crate) mod profile_statistics;
pub(crate) mod report;
pub(crate) mod result_folder;
pub(crate) mod statistics;
pub(crate) mod statistics_files;
pub(crate) mod summary;
pub(crate) mod surface_report;
