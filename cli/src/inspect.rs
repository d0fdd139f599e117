//! `tyndall inspect`.
use crate::arguments::InspectArguments;
use crate::failure::Error;
pub(crate) fn run(_arguments: &InspectArguments) -> Result<(), Error> {
    Ok(())
}
