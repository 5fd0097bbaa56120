//! The native master: executes the schedule on two components in this process.

use std::ops::ControlFlow;

use lander_models::signals::{Interface, Signal, connections};
use lander_models::{Component, ModelError, Settings, StepReport, Ticks};

use crate::schedule::{Action, Pair, Schedule, Side};

/// A component with its state and its values, whatever its type.
trait Participant {
    fn interface(&self) -> &'static Interface;
    fn inputs(&mut self) -> &mut [f64];
    fn outputs(&self) -> &[f64];
    fn step(&mut self, duration: Ticks) -> Result<StepReport, ModelError>;
}

struct Instance<C: Component> {
    component: C,
    state: C::State,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

impl<C: Component> Instance<C> {
    fn new(settings: &Settings) -> Result<Self, ModelError> {
        let (component, state) = C::create(settings)?;
        Ok(Self::of(component, state))
    }

    fn of(component: C, state: C::State) -> Self {
        let starts = C::INTERFACE.inputs.iter();
        let inputs = starts.flat_map(|s| (0..s.size).map(|index| s.start_of(index))).collect();
        let mut outputs = vec![0.0; C::INTERFACE.output_len()];
        component.outputs(&state, &mut outputs);
        Self { component, state, inputs, outputs }
    }
}

impl<C: Component> Participant for Instance<C> {
    fn interface(&self) -> &'static Interface {
        C::INTERFACE
    }

    fn inputs(&mut self) -> &mut [f64] {
        &mut self.inputs
    }

    fn outputs(&self) -> &[f64] {
        &self.outputs
    }

    fn step(&mut self, duration: Ticks) -> Result<StepReport, ModelError> {
        let report = self.component.step(&mut self.state, &self.inputs, duration)?;
        self.component.outputs(&self.state, &mut self.outputs);
        Ok(report)
    }
}

pub struct Master<'a> {
    schedule: &'a Schedule,
    participants: Pair<Box<dyn Participant>>,
    /// What each transfer of the schedule copies, in the order of its actions.
    links: Vec<Vec<Link>>,
    time: Ticks,
    row: Vec<f64>,
}

/// From output offset, to input offset, scalars.
type Link = (usize, usize, usize);

impl<'a> Master<'a> {
    /// Creates both components in their state at t = 0.
    pub fn new<T, G>(schedule: &'a Schedule, settings: &Settings) -> Result<Self, ModelError>
    where
        T: Component + 'static,
        G: Component + 'static,
        T::State: 'static,
        G::State: 'static,
    {
        let truth = Box::new(Instance::<T>::new(settings)?);
        let guidance = Box::new(Instance::<G>::new(settings)?);
        Ok(Self::with(schedule, Pair { truth: truth as _, guidance: guidance as _ }))
    }

    /// As `new`, for components that were made in memory, each with its state at t = 0.
    pub fn of<T, G>(
        schedule: &'a Schedule,
        (truth, truth_state): (T, T::State),
        (guidance, guidance_state): (G, G::State),
    ) -> Self
    where
        T: Component + 'static,
        G: Component + 'static,
        T::State: 'static,
        G::State: 'static,
    {
        let truth = Box::new(Instance::of(truth, truth_state));
        let guidance = Box::new(Instance::of(guidance, guidance_state));
        Self::with(schedule, Pair { truth: truth as _, guidance: guidance as _ })
    }

    fn with(schedule: &'a Schedule, participants: Pair<Box<dyn Participant>>) -> Self {
        let links = schedule.actions.iter().map(|action| match *action {
            Action::Transfer { from, to } => {
                connections(participants[from].interface(), participants[to].interface())
            }
            Action::Step { .. } | Action::Record {} => Vec::new(),
        });
        let links = links.collect();
        Self { schedule, participants, links, time: Ticks::ZERO, row: Vec::new() }
    }

    /// Runs until a component asks for the end, `stop_time` is reached, or `on_row` breaks.
    /// The first row holds the initial outputs.
    pub fn run<E: From<ModelError>>(
        &mut self,
        stop_time: Ticks,
        mut on_row: impl FnMut(&[f64]) -> Result<ControlFlow<()>, E>,
    ) -> Result<(), E> {
        let mut flow = on_row(self.row())?;
        while flow.is_continue() && self.time < stop_time {
            flow = self.communication_step(&mut on_row)?;
        }
        Ok(())
    }

    fn communication_step<E: From<ModelError>>(
        &mut self,
        on_row: &mut impl FnMut(&[f64]) -> Result<ControlFlow<()>, E>,
    ) -> Result<ControlFlow<()>, E> {
        let mut flow = ControlFlow::Continue(());
        self.time += self.schedule.communication_step;
        for (place, action) in self.schedule.actions.iter().enumerate() {
            match *action {
                Action::Transfer { from, to } => self.transfer(place, from, to)?,
                Action::Step { component } => {
                    let step = self.schedule.communication_step;
                    if self.participants[component].step(step)?.terminate {
                        flow = ControlFlow::Break(());
                    }
                }
                Action::Record {} => {
                    if on_row(self.row())?.is_break() {
                        flow = ControlFlow::Break(());
                    }
                }
            }
        }
        Ok(flow)
    }

    /// Refuses what an FMU refuses: an input that is not finite.
    fn transfer(&mut self, place: usize, from: Side, to: Side) -> Result<(), ModelError> {
        for &(output, input, size) in &self.links[place] {
            for offset in 0..size {
                let value = self.participants[from].outputs()[output + offset];
                if !value.is_finite() {
                    let inputs = self.participants[to].interface().inputs;
                    let name = scalar_name(inputs, input + offset);
                    return Err(ModelError::NonFiniteInput { name, value });
                }
                self.participants[to].inputs()[input + offset] = value;
            }
        }
        Ok(())
    }

    fn row(&mut self) -> &[f64] {
        self.row.clear();
        self.row.push(self.time.seconds());
        for side in &self.schedule.rows {
            self.row.extend_from_slice(self.participants[*side].outputs());
        }
        &self.row
    }
}

/// Name of the scalar at `position` of the flat list.
fn scalar_name(signals: &[Signal], position: usize) -> String {
    let mut names =
        signals.iter().flat_map(|signal| (0..signal.size).map(|index| signal.scalar_name(index)));
    names.nth(position).unwrap_or_default()
}
