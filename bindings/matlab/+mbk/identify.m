function [result, info] = identify(varargin)
% mbk.identify  Only the model: M, B, K and x0 with intervals and fit.
%
%   RESULT = mbk.identify(...) is the document that 'mbk identify --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.identify(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.identify(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.identify(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.identify(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.identify(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.identify(..., NAME, VALUE, ...)  options of 'mbk identify' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('identify', varargin);
end
