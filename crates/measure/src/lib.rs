//! Error metrics between pictures, and frame times.
