//! The text of a model: TOML in, the same TOML out.
//!
//! ```toml
//! [units]
//! q = "mm"                                                        # of the column, where its header names none
//! [terms]
//! linear_damping = 0.3                                            # held
//! stribeck_friction = "fit"                                       # its speed is to be fitted, too
//! dead_zone_stiffness = { coefficient = "maybe", gap = 0.01 }     # its gap is held
//! tip_drag = { coefficient = 0.2, v = 0.1 }
//! [effects.tip_drag]                                              # a user's own effect
//! expression = "abs(qd/v)^0.5*qd"
//! ```

use super::expression::Expression;
use super::hold::Hold;
use super::inner::InnerError;
use super::model::{Columns, Given, Model, ModelTerm};
use super::model_error::ModelError;
use super::own::Own;
use super::term::Term;
use super::unit::Channel;
use super::units::ColumnUnits;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    coordinates: Option<Vec<String>>,
    hold: Option<Hold>,
    #[serde(default)]
    columns: ByChannel,
    #[serde(default)]
    units: ByChannel,
    #[serde(default)]
    terms: toml::Table,
    #[serde(default)]
    potential: toml::Table,
    #[serde(default)]
    effects: toml::Table,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ByChannel {
    t: Option<String>,
    q: Option<String>,
    qd: Option<String>,
    #[serde(rename = "F")]
    excitation: Option<String>,
}

impl Model {
    /// Reads a table of terms, beside one of the user's own effects.
    ///
    /// # Errors
    /// [`ModelError`] names the key at fault.
    pub fn read_terms(
        terms: &toml::Table,
        effects: &toml::Table,
    ) -> Result<(Vec<ModelTerm>, Vec<Expression>), ModelError> {
        let mut expressions = read_expressions(effects)?;
        let terms = terms.iter().map(|(key, value)| read_term(key, value, &mut expressions));
        Ok((terms.collect::<Result<Vec<_>, _>>()?, expressions))
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`] names the key at fault and what would mend it.
    pub fn from_toml(text: &str) -> Result<Model, ModelError> {
        let file: File = toml::from_str(text).map_err(|error| ModelError::Syntax { message: error.to_string() })?;
        if let Some(names) = file.coordinates.filter(|names| names.as_slice() != ["q"]) {
            return Err(ModelError::Coordinates { names });
        }
        let (terms, expressions) = Model::read_terms(&file.terms, &file.effects)?;
        let potential = file.potential.keys().map(|key| read_potential(key)).collect::<Result<Vec<_>, _>>()?;
        let model = Model {
            name: file.name.unwrap_or_else(|| "unnamed".into()),
            hold: file.hold,
            columns: Columns {
                t: file.columns.t,
                q: file.columns.q,
                qd: file.columns.qd,
                excitation: file.columns.excitation,
                rest_is_guessed: false,
            },
            units: read_units(file.units)?,
            terms,
            potential,
            expressions,
        };
        model.check()?;
        Ok(model)
    }

    /// Writes the model as a file that [`Model::from_toml`] reads back to the same model.
    pub fn to_toml(&self) -> String {
        let quote = |text: &str| toml::Value::from(text).to_string();
        let mut text = format!("name = {}\ncoordinates = [\"q\"]\n", quote(&self.name));
        if let Some(hold) = self.hold {
            text += &format!("hold = \"{hold}\"\n");
        }
        let Columns { t, q, qd, excitation, .. } = &self.columns;
        text += &write_channels("columns", [t, q, qd, excitation]);
        let ColumnUnits { t, q, qd, excitation } = &self.units;
        text += &write_channels("units", [t, q, qd, excitation]);
        text += "\n[terms]\n";
        for term in &self.terms {
            text += &format!("{} = {}\n", quote(&term.key), self.write_term(term));
        }
        if !self.potential.is_empty() {
            text += "\n[potential]\n";
        }
        for term in &self.potential {
            text += &format!("{} = \"maybe\"\n", quote(&term.name()));
        }
        for expression in &self.expressions {
            text += &format!("\n[effects.{}]\n{}", expression.name(), self.write_expression(expression));
        }
        text
    }

    /// The value of a term: plain where nothing inside it is held.
    fn write_term(&self, entry: &ModelTerm) -> String {
        let coefficient = match entry.given {
            Given::Fit => "\"fit\"".to_string(),
            Given::Maybe => "\"maybe\"".to_string(),
            Given::Known(value) => toml::Value::from(value).to_string(),
        };
        let inner = self.inner_names(entry.term).into_iter().zip(entry.term.inner_values()).zip(&entry.open);
        let held = inner.filter(|(_, open)| !**open);
        let held: Vec<String> =
            held.map(|((name, value), _)| format!(", {name} = {}", toml::Value::from(value))).collect();
        match held.as_slice() {
            [] => coefficient,
            held => format!("{{ coefficient = {coefficient}{} }}", held.concat()),
        }
    }

    /// The body of a user's effect: its formula and the values at which inner parameters start that no term holds.
    fn write_expression(&self, expression: &Expression) -> String {
        let term = self.terms.iter().find(|entry| entry.key == expression.name());
        let is_open = |inner: usize| term.is_none_or(|entry| entry.open[inner]);
        let named = expression.parameters().iter().zip(expression.values()).enumerate();
        let starts = named.filter(|(inner, (_, value))| is_open(*inner) && **value != Expression::START);
        let starts = starts.map(|(_, (name, value))| format!("{name} = {}\n", toml::Value::from(*value)));
        format!("expression = {}\n{}", toml::Value::from(expression.text()), starts.collect::<String>())
    }
}

/// A table with a text for some of the channels t, q, qd, F; nothing where there is none.
fn write_channels(table: &str, texts: [&Option<String>; 4]) -> String {
    let lines = Channel::ALL.iter().zip(texts).filter_map(|(channel, text)| Some((channel.name(), text.as_deref()?)));
    let lines: String = lines.map(|(name, text)| format!("{name} = {}\n", toml::Value::from(text))).collect();
    if lines.is_empty() { lines } else { format!("\n[{table}]\n{lines}") }
}

fn read_units(file: ByChannel) -> Result<ColumnUnits, ModelError> {
    let units = ColumnUnits { t: file.t, q: file.q, qd: file.qd, excitation: file.excitation };
    for channel in Channel::ALL {
        let known = units.unit(channel).is_some_and(|unit| channel.accepts(unit.quantity));
        if let Some(unit) = units.written(channel).filter(|_| !known) {
            let (unit, known) = (unit.into(), channel.known_units());
            return Err(ModelError::Unit { channel: channel.name(), unit, meaning: channel.meaning(), known });
        }
    }
    Ok(units)
}

/// The user's effects, their inner parameters at their starts.
fn read_expressions(table: &toml::Table) -> Result<Vec<Expression>, ModelError> {
    if table.len() > Model::MAX_TERMS {
        return Err(ModelError::TooManyEffects { count: table.len(), max: Model::MAX_TERMS });
    }
    table.iter().map(|(name, value)| read_expression(name, value)).collect()
}

fn read_expression(name: &str, value: &toml::Value) -> Result<Expression, ModelError> {
    let legal =
        name.len() <= Own::LONGEST && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !legal || !name.starts_with(|letter: char| letter.is_ascii_alphabetic()) || Term::parse(name).is_ok() {
        return Err(ModelError::ExpressionName { name: name.into() });
    }
    let table = value.as_table().ok_or_else(|| ModelError::NoExpression { name: name.into() })?;
    let text = table.get("expression").and_then(toml::Value::as_str);
    let text = text.ok_or_else(|| ModelError::NoExpression { name: name.into() })?;
    let parsed = Expression::parse(name, text);
    let mut expression = parsed.map_err(|source| ModelError::Expression {
        name: name.into(),
        text: text.into(),
        source: source.into(),
    })?;
    let starts = read_inner(name, table, "expression", expression.parameters(), "effects")?;
    expression.set(&values(&starts, expression.values()));
    Ok(expression)
}

/// One term; sets the inner parameters of an expression that it names.
fn read_term(key: &str, value: &toml::Value, expressions: &mut [Expression]) -> Result<ModelTerm, ModelError> {
    let empty = toml::Table::new();
    let table = value.as_table().unwrap_or(&empty);
    let coefficient = match value.as_table() {
        Some(table) => table.get("coefficient"),
        None => Some(value),
    };
    let given = coefficient.map_or(Ok(Given::Fit), |coefficient| read_given(key, coefficient))?;
    let read = |names: &[String]| read_inner(key, table, "coefficient", names, "terms");
    let own = expressions.iter_mut().enumerate().find(|(_, expression)| expression.name() == key);
    let (term, inner) = match own {
        Some((index, expression)) => {
            let inner = read(expression.parameters())?;
            expression.set(&values(&inner, expression.values()));
            (expression.term(index), inner)
        }
        None => read_effect(Term::parse(key).map_err(|source| ModelError::Term { source })?, read)?,
    };
    Ok(ModelTerm { term, given, key: key.into(), open: inner.iter().map(Option::is_none).collect() })
}

type InnerValues = Vec<Option<f64>>;

/// The term with its inner parameters, and those that are held.
fn read_effect(
    term: Term,
    read: impl Fn(&[String]) -> Result<InnerValues, ModelError>,
) -> Result<(Term, InnerValues), ModelError> {
    let Term::Effect(effect) = term else { return Ok((term, read(&[])?)) };
    let names: Vec<String> = effect.inner().iter().map(|parameter| parameter.name.into()).collect();
    let inner = read(&names)?;
    let effect = effect.with_inner(&values(&inner, &effect.inner_values()));
    Ok((Term::Effect(effect.map_err(|source| ModelError::Inner { table: "terms", source: source.into() })?), inner))
}

fn values(inner: &[Option<f64>], defaults: &[f64]) -> Vec<f64> {
    inner.iter().zip(defaults).map(|(value, default)| value.unwrap_or(*default)).collect()
}

/// Values of the named inner parameters, none where one is to be fitted; refuses other keys but `beside`.
fn read_inner(
    key: &str,
    table: &toml::Table,
    beside: &str,
    names: &[String],
    place: &'static str,
) -> Result<InnerValues, ModelError> {
    if let Some(name) = table.keys().find(|name| *name != beside && !names.contains(name)) {
        let source = InnerError::Unknown { effect: key.into(), name: name.clone(), known: names.to_vec() };
        return Err(ModelError::Inner { table: place, source: source.into() });
    }
    let value = |name: &String| match table.get(name) {
        None => Ok(None),
        Some(value) if value.as_str() == Some("fit") => Ok(None),
        Some(value) => number(value).map(Some).ok_or_else(|| ModelError::InnerValue {
            key: key.into(),
            inner: name.clone(),
            value: value.to_string(),
        }),
    };
    names.iter().map(value).collect()
}

fn read_given(key: &str, value: &toml::Value) -> Result<Given, ModelError> {
    match (value.as_str(), number(value)) {
        (Some("fit"), _) => Ok(Given::Fit),
        (Some("maybe"), _) => Ok(Given::Maybe),
        (None, Some(number)) => Ok(Given::Known(number)),
        _ => Err(ModelError::Given { key: key.into(), value: value.to_string() }),
    }
}

/// A finite number.
fn number(value: &toml::Value) -> Option<f64> {
    let number = value.as_float().or_else(|| value.as_integer().map(|n| n as f64));
    number.filter(|number| number.is_finite())
}

fn read_potential(key: &str) -> Result<Term, ModelError> {
    match Term::parse(key) {
        Ok(term @ Term::Monomial(powers)) if powers.qd == 1 && powers.excitation == 0 => Ok(term),
        _ => Err(ModelError::Potential { key: key.into() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::effect::Effect;
    use crate::law::inner::Inner;

    const HEAD: &str = "name = \"x\"\n[terms]\nqdd = \"fit\"\n";

    fn read(terms: &str) -> Model {
        Model::from_toml(&format!("{HEAD}{terms}")).unwrap_or_else(|error| panic!("{terms}: {error}"))
    }

    #[test]
    fn inner_parameters_are_held_or_open() {
        let model = read(
            "dead_zone_stiffness = { coefficient = \"maybe\", gap = 0.01 }\nstribeck_friction = \"fit\"\n\
             hysteresis = { coefficient = 3, share = 0.7, exponent = \"fit\" }\none_sided_stop = { gap = 2 }\n",
        );
        let [dead_zone, stribeck, hysteresis, stop] = [1, 2, 3, 4].map(|index| &model.terms[index]);
        assert_eq!(dead_zone.term, Term::Effect(Effect::DeadZoneStiffness { gap: Inner::new(0.01) }));
        assert_eq!((dead_zone.given, dead_zone.open.as_slice()), (Given::Maybe, [false].as_slice()));
        assert_eq!(stribeck.open, [true]);
        assert_eq!((hysteresis.given, hysteresis.open.as_slice()), (Given::Known(3.0), [true, false, true].as_slice()));
        assert_eq!(hysteresis.term.inner_values()[1], 0.7);
        assert_eq!((stop.given, stop.term.inner_values()), (Given::Fit, vec![2.0]));
    }

    #[test]
    fn a_model_with_inner_parameters_and_expressions_survives_being_written() {
        let model = read(
            "dead_zone_stiffness = { coefficient = 1.5, gap = 0.01 }\nstribeck_friction = \"fit\"\n\
             hysteresis = { coefficient = \"maybe\", share = 0.7 }\ntip_drag = { coefficient = 0.2, v = 0.1 }\n\
             [effects.tip_drag]\nexpression = \"abs(qd/v)^p*qd\"\np = 0.5\n[effects.idea]\nexpression = \"F*sin(w*t)\"\nw = 3\n",
        );
        let text = model.to_toml();
        assert_eq!(Model::from_toml(&text).unwrap(), model, "{text}");
        let drag = &model.terms[4];
        assert_eq!((drag.term, drag.open.as_slice()), (model.expressions[0].term(0), [false, true].as_slice()));
        assert_eq!((drag.term.name(), drag.term.inner_values()), ("tip_drag".into(), vec![0.1, 0.5]));
        assert_eq!(model.expressions[1].values(), [3.0]);
    }

    #[test]
    fn every_effect_survives_being_written_with_its_inner_parameters() {
        for effect in Effect::ALL {
            let inner = effect.inner().iter().map(|parameter| format!(", {} = {}", parameter.name, parameter.default));
            let model = read(&format!("{} = {{ coefficient = 0.5{} }}", effect.id(), inner.collect::<String>()));
            assert_eq!(model.terms[1].term, Term::Effect(effect));
            assert_eq!(Model::from_toml(&model.to_toml()).unwrap(), model, "{}", model.to_toml());
            assert_eq!(model.check_streaming().is_ok(), effect.is_pointwise(), "{}", effect.id());
        }
    }

    #[test]
    fn units_of_columns_are_read_and_written() {
        let model = Model::from_toml("[units]\nq = \"mm\"\nF = \"kN\"\n[terms]\nqdd = \"fit\"").unwrap();
        assert_eq!((model.units.q.as_deref(), model.units.qd.as_deref()), (Some("mm"), None));
        assert_eq!(Model::from_toml(&model.to_toml()).unwrap(), model);
        for (units, named) in [
            ("q = \"furlong\"", "[units] q = \"furlong\" is no unit of a displacement"),
            ("F = \"mm\"", "[units] F = \"mm\" is no unit of an excitation"),
            ("x = \"mm\"", "unknown field `x`"),
        ] {
            let error = Model::from_toml(&format!("[units]\n{units}\n[terms]\nqdd = \"fit\"")).unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
    }

    #[test]
    fn bad_input_is_refused_by_name() {
        for (terms, named) in [
            (
                "dead_zone_stiffness = { slack = 0.1 }",
                "\"slack\" is no inner parameter of dead_zone_stiffness: write one of gap",
            ),
            ("linear_damping = { coefficient = 1, gap = 2 }", "it has none"),
            ("one_sided_stop = { gap = -0.1 }", "gap = -0.1 is out of range"),
            ("one_sided_stop = { gap = nan }", "gap = nan: write a finite number"),
            ("one_sided_stop = { gap = \"maybe\" }", "write a finite number"),
            ("one_sided_stop = { coefficient = inf }", "\"one_sided_stop\" = inf"),
            ("excitation_gain_nonlinearity = { power = 3 }\n\"F^3\" = \"fit\"", "are the same term"),
            ("tip = \"fit\"\n[effects.tip]\nexpression = \"q*\"", "[effects.tip] expression = \"q*\": at position 3"),
            (
                "tip = \"fit\"\n[effects.tip]\nexpression = \"a*q\"\nb = 2",
                "\"b\" is no inner parameter of tip: write one of a",
            ),
            ("tip = { c = 1 }\n[effects.tip]\nexpression = \"a*q\"", "[terms] \"c\" is no inner parameter of tip"),
            ("[effects.tip]\na = 1", "[effects.tip]: write expression"),
            ("[effects.qd]\nexpression = \"q\"", "[effects.qd]: choose another name"),
            ("tip = \"fit\"", "unknown term \"tip\""),
        ] {
            let error = Model::from_toml(&format!("{HEAD}{terms}")).unwrap_err().to_string();
            assert!(error.contains(named), "{terms}: {error}");
        }
    }

    #[test]
    fn a_stream_takes_pointwise_terms_with_held_inner_parameters() {
        assert_eq!(read("stribeck_friction = { speed = 0.1 }").check_streaming(), Ok(()));
        let own = "tip = { a = 2 }\n[effects.tip]\nexpression = \"a*abs(qd)^1.5*sign(qd)\"";
        assert_eq!(read(own).check_streaming(), Ok(()));
        assert_eq!(read("F = \"fit\"\nq = 4.0").check_streaming(), Ok(()), "a known stiffness gives forces a scale");
        for (terms, named) in [
            ("stribeck_friction = \"fit\"", "speed is not given"),
            ("excitation_delay = { delay = 0.1 }", "needs the past"),
            ("hysteresis = { yield_displacement = 0.1, share = 1, exponent = 1 }", "\"hysteresis\" cannot"),
            ("presliding_friction = { slip_length = 0.1 }", "\"presliding_friction\" cannot"),
            ("actuator_lag = { time = 0.1 }", "\"actuator_lag\" cannot"),
            ("tip = 1.0\n[effects.tip]\nexpression = \"q*t\"", "\"tip\" depends on the time"),
            ("tip = 1.0\n[effects.tip]\nexpression = \"a*q\"", "\"tip\": a is not given"),
            ("F = \"fit\"\nq = 0.0", "\"F\" stands on both sides"),
        ] {
            let error = read(terms).check_streaming().unwrap_err().to_string();
            assert!(error.contains(named), "{terms}: {error}");
        }
    }

    #[test]
    fn named_terms_keep_the_inner_parameters_of_the_model() {
        let model = read("one_sided_stop = { coefficient = 2, gap = 0.3 }");
        let fitted = model.with_terms(["qdd", "one_sided_stop", "dead_zone_stiffness"]).unwrap();
        assert_eq!((fitted.terms[1].given, fitted.terms[1].term), (Given::Fit, model.terms[1].term));
        assert_eq!((&fitted.terms[1].open, &fitted.terms[2].open), (&vec![false], &vec![true]));
    }
}
