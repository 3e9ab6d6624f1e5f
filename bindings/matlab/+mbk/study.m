function [result, info] = study(what, varargin)
% mbk.study  The commands 'mbk study ...': init, add, import, list, show, measure, exclude, summary, export, forget, check, log, backup.
%
%   [RESULT, INFO] = mbk.study('init', ..., NAME, VALUE, ...) does what 'mbk study init' does. Behind the name of the
%   command stand data (see 'help mbk.measure'), names of files or other words, as a text or a cell of several, and then
%   options with their values. RESULT is the document of --json as a struct, or text where the command has none.
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['study ' char(what)], varargin);
end
