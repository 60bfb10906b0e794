//! Reading and writing records and tables of results.
